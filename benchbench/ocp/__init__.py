"""What is asked (scenario, motion, contact, gates, model) and what a plan is; no transcription, no solver."""

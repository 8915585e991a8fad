"""The waist: an MPCC as data, its derivatives and its residuals."""

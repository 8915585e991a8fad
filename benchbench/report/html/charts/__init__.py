"""One file per chart: from named runs to a Plotly figure with its words."""

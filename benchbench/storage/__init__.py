"""What a run leaves behind: one typed record, a table of records, a recording of the plan."""

"""A user's own part in one file, docs/job.md: its grammar, the problem it describes, and what is written about its solution."""

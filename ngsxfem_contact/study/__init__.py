"""The study of section 4 of [AHLMR12]."""

"""(12) of [AHLMR12] and its relatives: the cones, the laws of friction, the stabilisations, the systems, the problem and its solution."""

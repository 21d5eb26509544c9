"""Stress intensity factors, energy release rates, growth: read from functions in V_h and their stresses, however they were found."""

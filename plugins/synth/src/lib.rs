//! Sounds made from numbers: bells, water, wind, steps.

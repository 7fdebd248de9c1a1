"""Recordings spoiled in the ways of the world's loggers, with the truth beside each.

A clean recording is a set of known functions of time, so that the truth is exact at any instant,
whatever a logger did to its rows. Every spoiling is one that a person with the file in an editor
could undo; what no person could (a header without names, an angle in counts of an unknown encoder,
lost samples under stamps coarser than the sampling) is not in the list or not in that combination.

clean -> timing (rows and stamps) -> naming (words and units) -> layout (text) -> files;
`drawing` says what goes with what, `judging` compares what was read with the truth.
"""

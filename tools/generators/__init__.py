"""Recordings of machines that no part of drivescope simulated.

The plant and what judges it must not flatter each other. Here the equations are integrated by a
method of their own, ten times finer than the samples, and the laws differ in form from the
library's: other exponents, extra harmonics, another zero-speed law. Many machines are stepped
together as numpy arrays.

machine -> excitation -> stepping (balance, laws) -> measuring -> files; `cases` puts them together.
`wide` draws machines of any size (sizes), at operating points (operating, control), with loads of
several kinds (loads) and sensors of several kinds (channels).
"""

"""Sweeps larger than memory: written chunk by chunk to a Zarr store, on one machine or a Dask cluster.

sweep     what `desaxe.sweep` does with names and inputs
place     whether a store may be written at a place, and has room there
peak_step refined peaks of the designs of a sweep
estimate  size, time and free disk before it starts
memory    how much memory is free
request   what identifies a sweep, and how two differ
layout    chunks and the memory that they take
skeleton  metadata and coordinates of a store: what they must be, and what they are
store     the store: its skeleton, chunks that are whole or absent, what is left to do
tasks     a chunk as a task that travels to a worker, and where its arrays go: a store, memory
cluster   tasks in threads or on a Dask cluster, a bounded number at a time
"""

"""Sweeps larger than memory: blocks of a plan in a Zarr store, on one machine or a Dask cluster.

sweep      what `desaxe.sweep` does with names and inputs
request    a sweep that is ready to run: plan, chunks and identity
layout     chunks, and the memory that they take
peak_step  refined peaks of the designs of a sweep
store      the Zarr store: made, checked, locked; chunks that are whole or absent
workers    blocks on threads or on a Dask cluster
"""

"""Sweeps larger than memory: blocks of a plan in a Zarr store, on one machine or a Dask cluster.

request    a sweep that is ready to run: plan, chunks, the memory that they take, identity
peak_step  refined peaks of the designs of a sweep
store      the Zarr store: made, checked, locked; chunks that are whole or absent
sweep      a sweep that runs: its blocks on threads or on a Dask cluster
"""

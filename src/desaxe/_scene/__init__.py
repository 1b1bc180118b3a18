"""Scenes: a mechanism, its motion and what is wanted of it, as data.

scene      `desaxe.scene`: Scene and SceneResult
schema     the keys of a scene file, their types and what they mean
values     numbers with units, lists and ranges as SI numbers
printed    values as a paper prints them, to be compared digit by digit
read       a file or mapping, checked, as Content
json_schema  the same for editors
run        Content -> grid, checks, files
peaks      its peaks over designs
write      files: NetCDF, Zarr, CSV, npz
text       the report
progress   told while it runs
"""

from .model import Scene as Scene
from .model import SceneError as SceneError
from .model import SceneResult as SceneResult
from .model import scene as scene

"""Scenes: a mechanism, its motion and the requested quantities, as data.

scene        `desaxe.scene`: Scene and SceneResult
schema       the keys of a scene file, their types and what they mean
json_schema  the schema for editors
setting      the machine of a scene, and how all of its requests are computed
content      the machine and its requests, checked and in SI units
run          Content -> values, peaks, checks, then files
report       the result as text
command      `desaxe run`
load_tables  a load as the table of a scene file
toml_text    keys and values as TOML
sweep        `desaxe.sweep`
reading/     a file or mapping as Content
parts/       its requests, each read, run and explained: grid, checks, peaks, steady states, pictures
stores/      what it writes, and where
document/    the result as a page to hand on, HTML or Markdown
explain/     what a scene will do before it does it
export/      a scene as a module of its own
explorer/    a scene as a page for the browser
"""

"""Scenes: a machine and a list of requests, as data.

scene        `desaxe.scene`: Scene and SceneResult; a run computes all answers, then writes the files
schema       the keys of a scene file, their types and what they mean; the schema for editors
content      the machine and its requests, checked and in SI units; plans and answers
loads        loads and motors: one table of their keys
written      a scene as text: numbers, loads, TOML
command      `desaxe run`
sweep        `desaxe.sweep`
reading/     a file or mapping as Content
parts/       the requests, each from its table to its section of the report: grid, checks, peaks, ...
stores/      what it writes, and where
document/    blocks of a report and their renderers; the page to hand on, HTML or Markdown
explain/     what a scene will do before it does it
export/      a scene as a module of its own
explorer/    a scene as a page for the browser
"""

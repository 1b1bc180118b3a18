"""From a request to something callable: texts, machine code, the native calling convention."""

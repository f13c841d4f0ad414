TOOL: str
DATA: str

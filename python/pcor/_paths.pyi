TOOL: str
MODELS: str

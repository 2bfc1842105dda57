gr.node("é"

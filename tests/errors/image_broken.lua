-- expect: SCRIPT:2: gr.texture: lib/broken.png: truncated PNG: the file ends at byte 27, before the picture is complete
gr.texture('lib/broken.png')

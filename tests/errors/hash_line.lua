#!/usr/bin/env gray
-- expect: SCRIPT:3: gr.sphere: material or name must be a material or a string, not a boolean
gr.sphere(true)

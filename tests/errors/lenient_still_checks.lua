-- expect: SCRIPT:4: gr.sphere: radius must be > 0
-- arguments: --lenient
gr.frobnicate('a'):spin(3)
gr.sphere{radius = 0}

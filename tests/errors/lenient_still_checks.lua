-- expect: SCRIPT:5: the end
-- arguments: --lenient
gr.frobnicate('a'):spin(3)
gr.sphere{radius = 0}
error('the end')

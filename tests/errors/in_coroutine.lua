-- expect: SCRIPT:2: gr.sphere: radius must be > 0
coroutine.wrap(function() gr.sphere{radius = 0} end)()

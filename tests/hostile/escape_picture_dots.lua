-- expect: SCRIPT:3: gr.render: a/../../x.png: pictures of scripts must be below the working directory, without a hidden name (-o FILE or --allow-write DIR allow other places)
-- A folder that need not exist, and two levels up from it.
gr.render{node = gr.sphere{}, file = 'a/../../x.png', width = 8, height = 8, eye = {0, 0, 9}, lights = {}}

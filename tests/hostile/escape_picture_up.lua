-- expect: SCRIPT:2: gr.render: ../harm.png: pictures of scripts must be below the working directory, without a hidden name (-o FILE or --allow-write DIR allow other places)
gr.render(gr.node('n'), '../harm.png', 8, 8, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})

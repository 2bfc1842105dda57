-- expect: SCRIPT:2: gr.height_field: heights[2] has 3 numbers, but heights[1] has 2
gr.height_field{heights={{0, 1}, {0, 1, 2}}}

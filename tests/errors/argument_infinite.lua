-- expect: SCRIPT:2: node:scale: z must be finite (node 'n')
gr.node('n'):scale(1, 1, math.huge)

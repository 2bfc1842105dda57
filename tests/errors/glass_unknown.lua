-- expect: SCRIPT:2: gr.glass: glass must be 'N-BK7', 'N-BK10', 'N-K5', 'N-FK5', 'N-FK51A', 'N-BAK4', 'N-SK16', 'N-BAF10', 'N-LASF9', 'F2', 'N-F2', 'N-SF5', 'N-SF10', 'N-SF11', 'SF11', 'SF10', 'N-SF6', 'N-SF66', 'silica', 'fluorite', 'sapphire', 'diamond' or 'water', not 'NBK7'; did you mean 'N-BK7'?
gr.glass{glass = 'NBK7'}

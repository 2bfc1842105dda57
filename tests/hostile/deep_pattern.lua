-- expect: SCRIPT:2: pattern too complex
('x'):rep(300000):find(('(x?'):rep(1) .. ('x?'):rep(300000))

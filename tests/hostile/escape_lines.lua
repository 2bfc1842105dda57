-- expect: SCRIPT:2: /etc/passwd: lies outside*
for _ in io.lines('/etc/passwd') do end

-- expect: SCRIPT:3: os.exit: the script says that it failed
while true do
    pcall(function() os.exit(1) end)
end

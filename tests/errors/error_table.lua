-- expect: SCRIPT:2: the script raised a table
error({})

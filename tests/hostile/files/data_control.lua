return 

link-ask = Open this page in your browser?
link-open = Open
link-stay = Stay here

link-ask = Aprire questa pagina nel browser?
link-open = Apri
link-stay = Resta qui

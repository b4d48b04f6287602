link-ask = Otevřít tuto stránku v prohlížeči?
link-open = Otevřít
link-stay = Zůstat tady

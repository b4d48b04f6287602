# When controls are heard
scope-moving = A piedi e in volo
scope-foot = A piedi
scope-air = In volo
scope-examining = Durante l’esame

# What controls do
control-walk-forward = cammina avanti
control-walk-back = cammina indietro
control-walk-left = passo a sinistra
control-walk-right = passo a destra
control-walk-run = corri
control-walk-fly = vola e atterra
control-walk-examine = esamina ciò che guardi, e riprendi a camminare
control-look-hold = guardati intorno finché è premuto
control-look-left = gira a sinistra
control-look-right = gira a destra
control-look-up = guarda in su
control-look-down = guarda in giù
control-view-narrow = campo visivo stretto
control-view-natural = campo visivo naturale
control-view-wide = campo visivo ampio
control-view-next = il campo visivo successivo
control-eye-lower = occhi più in basso
control-eye-higher = occhi più in alto
control-fly-rise = sali
control-fly-sink = scendi
control-examine-drag = gira finché è premuto
control-examine-nearer = più vicino
control-examine-farther = più lontano

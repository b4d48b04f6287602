# When controls are heard
scope-moving = Pěšky i ve vzduchu
scope-foot = Pěšky
scope-air = Ve vzduchu
scope-examining = Při prohlížení

# What controls do
control-walk-forward = jít vpřed
control-walk-back = jít vzad
control-walk-left = krok vlevo
control-walk-right = krok vpravo
control-walk-run = běžet
control-walk-fly = vzlétnout a přistát
control-walk-examine = prohlédnout si, na co se díváte, a jít dál
control-look-hold = rozhlížet se, dokud je stisknuto
control-look-left = otočit se vlevo
control-look-right = otočit se vpravo
control-look-up = pohlédnout vzhůru
control-look-down = pohlédnout dolů
control-view-narrow = úzké zorné pole
control-view-natural = přirozené zorné pole
control-view-wide = široké zorné pole
control-view-next = další zorné pole
control-eye-lower = oči níž
control-eye-higher = oči výš
control-fly-rise = stoupat
control-fly-sink = klesat
control-examine-drag = otáčet tím, dokud je stisknuto
control-examine-nearer = blíž
control-examine-farther = dál

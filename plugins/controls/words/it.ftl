# When controls are heard
scope-always = Sempre

# What controls do
control-window-close = chiudi l’ultima cosa aperta

# What can be pressed
key-space = Spazio
key-enter = Invio
key-right = { $key } destro
input-mouse-left = tasto sinistro del mouse
input-mouse-right = tasto destro del mouse
input-mouse-middle = tasto centrale del mouse
input-mouse-back = tasto indietro del mouse
input-mouse-forward = tasto avanti del mouse
input-mouse-other = tasto { $n } del mouse
input-wheel-up = rotella in avanti
input-wheel-down = rotella indietro
input-pad = gamepad { $button }
input-pad-cross = croce { $way }
input-stick-left = levetta sinistra { $way }
input-stick-right = levetta destra { $way }
input-touch = dito { $way }
input-none = niente

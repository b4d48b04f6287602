# When controls are heard
scope-always = Kdykoli

# What controls do
control-window-close = zavřít, co se otevřelo naposled

# What can be pressed
key-space = mezerník
key-enter = Enter
key-right = pravý { $key }
input-mouse-left = levé tlačítko myši
input-mouse-right = pravé tlačítko myši
input-mouse-middle = prostřední tlačítko myši
input-mouse-back = tlačítko myši zpět
input-mouse-forward = tlačítko myši vpřed
input-mouse-other = tlačítko myši { $n }
input-wheel-up = kolečko od sebe
input-wheel-down = kolečko k sobě
input-pad = ovladač { $button }
input-pad-cross = kříž { $way }
input-stick-left = levá páčka { $way }
input-stick-right = pravá páčka { $way }
input-touch = prst { $way }
input-none = nic

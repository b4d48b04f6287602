# When controls are heard
scope-always = At any time

# What controls do
control-window-close = close what was opened last

# What can be pressed
key-space = Space
key-enter = Enter
key-right = right { $key }
input-mouse-left = left mouse button
input-mouse-right = right mouse button
input-mouse-middle = middle mouse button
input-mouse-back = mouse button back
input-mouse-forward = mouse button forward
input-mouse-other = mouse button { $n }
input-wheel-up = wheel forward
input-wheel-down = wheel back
input-pad = Pad { $button }
input-pad-cross = D-pad { $way }
input-stick-left = left stick { $way }
input-stick-right = right stick { $way }
input-touch = finger { $way }
input-none = nothing

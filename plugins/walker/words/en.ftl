# When controls are heard
scope-moving = On foot and in the air
scope-foot = On foot
scope-air = In the air
scope-examining = Examining

# What controls do
control-walk-forward = walk forward
control-walk-back = walk back
control-walk-left = step left
control-walk-right = step right
control-walk-run = run
control-walk-fly = fly, and land
control-walk-examine = examine what you look at, and walk on
control-look-hold = look around as long as it is held
control-look-left = turn left
control-look-right = turn right
control-look-up = look up
control-look-down = look down
control-view-narrow = narrow view
control-view-natural = natural view
control-view-wide = wide view
control-view-next = the next field of view
control-eye-lower = eyes lower
control-eye-higher = eyes higher
control-fly-rise = rise
control-fly-sink = sink
control-examine-drag = turn it as long as it is held
control-examine-nearer = nearer
control-examine-farther = farther

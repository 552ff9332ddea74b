cp "${0%/*}/axle.spec" . && cat "${0%/*}/part_no_step.spec"

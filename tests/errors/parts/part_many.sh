i=0
while [ $i -lt 12 ]; do
	printf 'model d%d\nuse "d%d.spec" as a, b\n' $i $((i + 1)) >d$i.spec
	i=$((i + 1))
done
printf "model d12\ncoord x\nx'' + x = 0\n" >d12.spec
printf 'model part_many\nuse "d0.spec" as d\nstep 0.01\n'

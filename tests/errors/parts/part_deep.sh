i=0
while [ $i -lt 40 ]; do
	printf 'model d%d\ncoord x\nuse "d%d.spec" as d\nx'"''"' + x = 0\n' $i $((i + 1)) >d$i.spec
	i=$((i + 1))
done
printf "model d40\ncoord x\nx'' + x = 0\n" >d40.spec
printf 'model part_deep\nuse "d0.spec" as d\nstep 0.01\n'

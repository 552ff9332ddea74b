# names of files are relative to the text that has them
mkdir -p parts/more
printf '%%%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1\n2\n' >parts/more/k.mtx
printf '%%%%MatrixMarket matrix array real general\n2 2\n3\n-1\n-1\n3\n' >k.mtx
printf "model inner\ncoord q[2]\nmatrix K = \"k.mtx\"\nq'' + K*q = 0\n" >parts/more/inner.spec
printf 'model outer\nuse "more/inner.spec" as one, two\nspring 1 between one.q[1], two.q[2]\n' >parts/outer.spec
printf 'model part_folders_good\nuse "parts/outer.spec" as a\n'
printf 'use "parts/more/inner.spec" as b with K = "k.mtx", q = [1; 2]\n'
printf 'spring 3 between a.one.q[1], b.q[2]\nstep 0.01\n'

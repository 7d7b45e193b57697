# The figure of bench/run.sh: ms per frame over people, one thread, one panel per density.
# gnuplot -e "results='results.csv'; figure='comparison.svg'; cpu='name'" bench/comparison.gp
set terminal svg size 1000,560 font "sans,12" background "white"
set output figure
set datafile separator ","
set logscale xy
set grid
set key below horizontal maxcols 3
set xrange [400:125000]
set xlabel "people"
set ylabel "ms per frame (median)"
set format y "%g"
engines = "throng throng_boxes embree fcl cgal bullet ode"
titles = "'throng: or-DOP 26 pairs' 'throng: boxes only' 'Embree' 'FCL' 'CGAL' 'Bullet' 'ODE'"
rows(engine, density) = sprintf( \
  "< awk -F, '$6 == \"%s\" && $2 == %s && $3 == 1' '%s'", engine, density, results)
set multiplot layout 1,2 title cpu.", one thread"
do for [density in "1 4"] {
  set title density." people per m^2"
  plot for [i = 1:words(engines)] rows(word(engines, i), density) using 1:9 \
    with linespoints linewidth (i == 1 ? 3 : 1.5) title word(titles, i)
}
unset multiplot

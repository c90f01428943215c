# Completion of lanternfish for bash, printed by `lanternfish completion bash`: do not edit.
_lanternfish() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options= i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
      run|campaign|compare|serve|render-frames|scenarios|reach|peaks|plane|markers|ik|check|new|export|bench|doctor|version|help|completion) command=${COMP_WORDS[i]}; break ;;
    esac
  done
  case $command in
    '')
      options='--help --version'
      ;;
    'run')
      case $before in
        --seed) :; return ;;
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
        --out) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --render-threads) :; return ;;
      esac
      options='--help --seed --set --out --realtime --render-threads --record-images --no-outside --quiet --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'campaign')
      case $before in
        --seeds) COMPREPLY=($(compgen -W "$(true)" -- "$word")); return ;;
        --draws) :; return ;;
        --many) :; return ;;
        --kinds) COMPREPLY=($(compgen -W "$(true)" -- "$word")); return ;;
        --steps) COMPREPLY=($(compgen -W "$(true)" -- "$word")); return ;;
        --rows) COMPREPLY=($(compgen -W "$(true)" -- "$word")); return ;;
        --one-in) :; return ;;
        --into) :; return ;;
        --shard) COMPREPLY=($(compgen -W "$(true)" -- "$word")); return ;;
        --jobs) :; return ;;
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
        --out) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --compare) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --across) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --seeds --faults --ranges --draws --many --kinds --steps --rows --rendered --pairs --one-in --into --shard --jobs --set --out --compare --across --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'compare')
      case $before in
        --across) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --across --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'serve')
      case $before in
        --can) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --camera) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --nodes) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --homing) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --seed) :; return ;;
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
        --renderer) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --render-threads) :; return ;;
        --orders) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --out) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --for) :; return ;;
      esac
      options='--help --can --camera --nodes --homing --seed --set --renderer --render-threads --orders --out --for --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'render-frames')
      case $before in
        --seed) :; return ;;
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
        --render-threads) :; return ;;
      esac
      options='--help --seed --set --render-threads --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'scenarios')
      case $before in
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
      esac
      options='--help --set --schema --keys --faults --scene-schema --scene-keys --machine-schema --panel-schema --panel-keys --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'reach')
      case $before in
        --set) compopt -o nospace; COMPREPLY=($(compgen -W "$(lanternfish scenarios --keys 2>/dev/null | sed -n "s/^| .\([a-z_.]*\). | .*/\1=/p")" -- "$word")); return ;;
        --out) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --draws) :; return ;;
      esac
      options='--help --set --out --draws --json'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(lanternfish scenarios 2>/dev/null | cut -d" " -f1)" -- "$word")); COMPREPLY+=($(compgen -f -- "$word")); return; }
      ;;
    'peaks')
      case $before in
        --off) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --axis) COMPREPLY=($(compgen -W "$(printf '%s\n' column row)" -- "$word")); return ;;
        --channel) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --overlay) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --off --axis --channel --overlay --csv --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'plane')
      case $before in
        --threshold-mm) :; return ;;
      esac
      options='--help --threshold-mm --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'markers')
      case $before in
        --family) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --channel) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --camera) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --size-m) :; return ;;
        --decimate) :; return ;;
        --margin) :; return ;;
        --overlay) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --family --channel --camera --size-m --decimate --margin --overlay --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'ik')
      case $before in
        --x) :; return ;;
        --y) :; return ;;
        --z) :; return ;;
        --roll) :; return ;;
        --approach) :; return ;;
        --margin) :; return ;;
        --arm) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --x --y --z --roll --approach --margin --arm --json'
      ;;
    'check')
      case $before in
        --base) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --tool) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --approach) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --opening) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --packages) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
        --postures) :; return ;;
        --picture) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --base --tool --approach --opening --packages --ignore-missing --postures --picture --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'new')
      options='--help'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'export')
      case $before in
        --out) compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return ;;
      esac
      options='--help --out'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'bench')
      options='--help --json'
      [[ $word == -* ]] || { compopt -o filenames; COMPREPLY=($(compgen -f -- "$word")); return; }
      ;;
    'doctor')
      options='--help --json'
      ;;
    'version')
      options='--help --json'
      ;;
    'help')
      options='--help'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(printf "%s\n" run campaign compare serve render-frames scenarios reach peaks plane markers ik check new export bench doctor version help completion)" -- "$word")); return; }
      ;;
    'completion')
      options='--help'
      [[ $word == -* ]] || { COMPREPLY=($(compgen -W "$(printf '%s\n' bash zsh)" -- "$word")); return; }
      ;;
  esac
  [ -n "$command" ] || options+=' run campaign compare serve render-frames scenarios reach peaks plane markers ik check new export bench doctor version help completion'
  COMPREPLY=($(compgen -W "$options" -- "$word"))
}
complete -F _lanternfish lanternfish

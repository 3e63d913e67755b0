#!/usr/bin/env bash
# Inside a folder too includes point downwards only, in the order of its rooms: a file includes those of its own room
# and of rooms before it. What is not listed, the folder's door, comes last. A header of the door may be listed: it
# declares what the rooms after it do.
set -euo pipefail
source "$(dirname "$0")/sources.sh"
status=0
downwards() {  # downwards FOLDER ROOM...
  local folder=$1 upwards
  shift
  upwards=$(sources "$folder/*.hpp" "$folder/*.cpp" "$folder/*.h" | grep -vE '_test\.cpp$|/testing/' |
    xargs -r grep -oHE "#include \"$folder/[^\"]+" | awk -v folder="$folder" -v rooms="$*" '
      function rank(path, parts) {
        sub("^" folder "/", "", path)
        split(path, parts, "/")
        return parts[1] in order ? order[parts[1]] : last
      }
      BEGIN {
        last = split(rooms, room, " ") + 1
        for (i = 1; i < last; ++i) order[room[i]] = i
      }
      {
        file = $0; sub(/:#include.*/, "", file)
        included = $0; sub(/.*"/, "", included)
        if (rank(included) > rank(file)) print file " includes " included
      }')
  if [ -n "$upwards" ]; then
    printf '%s: includes point upwards:\n%s\n' "$folder" "$upwards"
    status=1
  fi
  for room in $(sources "$folder/*/*" | sed "s#^$folder/##" | cut -d/ -f1 | sort -u); do
    case " $* testing packaging examples messages " in
      *" $room "*) ;;
      *) printf '%s/%s has no place in the order of rooms (%s)\n' "$folder" "$room" "$0"; status=1 ;;
    esac
  done
}
downwards formats layout layout.hpp view view.hpp stored_blocks.hpp ready verify.hpp verify output write transport mesh store trajectory
downwards runtime loop.hpp constraint.hpp vec.hpp light.hpp model.hpp mask.hpp stiffness.hpp price_list.h prices.hpp local_model.hpp memory algebra wavelet compliance factor friction elastostatic.hpp \
  elastostatic impulse_response.hpp impulse_response multigrid.hpp multigrid surface.hpp surface finer_surface.hpp display bound_mesh.hpp look.hpp contact contact_body.hpp contact_body vibrating_body.hpp relief.hpp \
  recorder.hpp recorder hosted
downwards offline progress.hpp single_threaded_blas.hpp surface remesh wrap volume multigrid sources scene simulate reduce appearance compress pipeline report figures cli
downwards offline/compress wavelet encode measure search
downwards sim_hw guard body messages device transport control_loop drag motion session
exit $status

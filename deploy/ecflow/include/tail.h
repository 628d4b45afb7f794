ecflow_client --complete
trap - ERR EXIT TERM INT HUP

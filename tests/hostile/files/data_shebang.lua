#!/bin/sh
return }

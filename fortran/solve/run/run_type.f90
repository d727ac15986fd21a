!> A run between two increments: its state, the workspace, and the reports so far.
module lopin_run_type
   use lopin_checksum, only : checksum_type
   use lopin_report, only : frame_type, summary_type
   use lopin_loading, only : loading_type
   use lopin_plan, only : plan_type
   use lopin_scene, only : scene_type
   use lopin_after_step, only : step_record_type
   use lopin_check_drift, only : drift_type
   use lopin_artificial_work, only : artificial_type
   use lopin_work_balance, only : balance_type
   use lopin_snap_through, only : snap_through_type
   use lopin_needless_order, only : needless_type
   use lopin_springback, only : springback_type
   use lopin_force_ripples, only : ripples_type
   use lopin_facet_sag, only : sag_type
   use lopin_soft_springs, only : soft_springs_type
   implicit none
   private
   public :: run_type, watch_type

   !> What was seen of the run so far: warnings and reports come of it.
   type :: watch_type
      type(step_record_type) :: seen           !! how near the pairs came
      type(drift_type) :: drift                !! bodies that nothing has stopped
      type(artificial_type) :: artificial      !! work of what held floating bodies
      type(balance_type) :: balance            !! work that is lost
      type(snap_through_type) :: jumps         !! to other equilibria
      type(springback_type) :: springback      !! work done in a release
      type(ripples_type) :: ripples            !! forces that rise and fall with the facets
      type(sag_type) :: sag                    !! flat facets on curved tools
      type(soft_springs_type) :: springs       !! of contact that give way beside the bodies
      type(needless_type) :: needless          !! second order that no step called for
      type(checksum_type) :: checksum          !! of the displacements of all nodes so far
   end type watch_type

   type :: run_type
      type(scene_type), allocatable :: scene   !! may be made again at any time from the rest
      type(plan_type) :: plan
      type(loading_type) :: loading            !! of the step
      type(watch_type) :: watch
      type(summary_type) :: summary
      type(frame_type) :: frame                !! the last increment that was accepted
      logical :: in_step = .false.             !! a step is begun and not ended
      logical :: may_step = .false.            !! opened, without an error so far
   end type run_type
end module lopin_run_type

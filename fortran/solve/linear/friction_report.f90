!> Messages about friction: elastic slip, wedging, tension, states that cycle.
module lopin_friction_report
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_body_words, only : describe_motion
   use lopin_active_set, only : outcome
   use lopin_cone_balance, only : find_unheld_motion
   use lopin_friction_rows, only : friction_points_type
   use lopin_friction_limits, only : find_wedging
   use lopin_friction_set, only : friction_result_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: report_elastic_slip, warn_of_wedging, warn_of_tension, explain

contains

   !> The elastic slip of penalty pairs, where it was not given, is said once.
   subroutine report_elastic_slip(scene, model, points)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer :: k, i, pair

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == 'N0520') return
      end do
      do k = 1, points%n
         associate (law => points%law(k))
            if (.not. points%elastic_slip(k) > 0.0_wp) cycle
            if (law%elastic_slip > 0.0_wp .or. law%slip_tolerance > 0.0_wp) cycle
         end associate
         pair = scene%points%pair(scene%rows%point(points%normal(k)))
         call scene%log%say(severity%note, 'N0520', 'sticking points of this penalty pair give '// &
            & 'way by up to '//to_text(points%elastic_slip(k), 4)//', 0.5 % of a facet', &
            & model%pair(pair)%at, help='ELASTIC SLIP= on *FRICTION sets it; DIRECT sticks exactly')
         return
      end do
   end subroutine report_elastic_slip

   !> Several answers may exist: said once a step, with the node and its critical coefficient.
   subroutine warn_of_wedging(scene, model, points, friction)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      real(wp) :: coefficient, critical
      integer :: worst

      if (scene%answer%outcome /= outcome%solved) return
      call find_wedging(scene%problem%s, points, friction%status, worst, coefficient, critical)
      if (worst > 0) then
         call warn(scene, model, 'W0520', 'frictional wedging: several equilibria are possible '// &
            & 'at the coefficient '//to_text(coefficient, 4)//'; node '//label_of(scene, model, &
            & points, worst)//' has one below '//to_text(critical, 6), 'the answer is the '// &
            & 'one that the load history leads to; smaller increments follow it more surely')
      else if (friction%sign_of_determinant < 0) then
         call warn(scene, model, 'W0520', 'frictional wedging: several equilibria are '// &
            & 'possible, because the slipping points together press themselves on', 'the '// &
            & 'answer is the one that the load history leads to; smaller increments follow it '// &
            & 'more surely')
      end if
   end subroutine warn_of_wedging

   !> What never separates may pull: friction then has no bound to read.
   subroutine warn_of_tension(scene, model, points)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer :: k

      do k = 1, points%n
         if (.not. points%at(k)%held .or. points%law(k)%rough) cycle
         if (.not. scene%answer%force(points%normal(k)) < 0.0_wp) cycle
         call warn(scene, model, 'W0521', 'node '//label_of(scene, model, points, k)// &
            & ' is pulled by NO SEPARATION: friction there is that of no pressure', &
            & 'TIED or ROUGH also hold along the face')
         return
      end do
   end subroutine warn_of_tension

   !> A warning of the run, once for each step.
   subroutine warn(scene, model, id, message, help)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: id, message, help
      integer :: i

      do i = 1, scene%log%n
         if (scene%log%item(i)%id == id .and. scene%log%item(i)%at%line &
            & == model%step(scene%step)%at%line) return
      end do
      call scene%log%say(severity%warning, id, message, model%step(scene%step)%at, help=help)
   end subroutine warn

   function label_of(scene, model, points, k) result(label)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      integer, intent(in) :: k
      character(len=:), allocatable :: label
      label = to_text(model%mesh%node_label(scene%points%node(scene%rows%point(points%normal(k)))))
   end function label_of

   !> What the outcome means, as an error.
   subroutine explain(scene, model, points, friction, moving, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(friction_points_type), intent(in) :: points
      type(friction_result_type), intent(in) :: friction
      real(wp), intent(in) :: moving(:)        !! (nq) load on the floating motions
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: nodes
      real(wp), allocatable :: motion(:)
      integer :: i
      logical :: unheld

      if (.not. any(scene%answer%outcome == [outcome%cycling, outcome%not_held])) return
      call find_unheld_motion(scene%problem%c, scene%problem%bilateral, points, moving, motion, &
         & unheld)
      if (unheld) then
         call raise(error, error_code%singular, 'E0310', describe_motion(scene%bodies, model, &
            & motion)//': contact and friction do not hold it under this load', &
            & model%step(scene%step)%at, note='no forces within the cones of friction balance '// &
            & 'the load, however the bodies deform', help='more friction, a support, or drive '// &
            & 'it by displacement (*BOUNDARY)')
      else if (scene%answer%outcome == outcome%cycling) then
         nodes = ''
         do i = 1, min(8, size(friction%changing))
            nodes = nodes//' '//label_of(scene, model, points, friction%changing(i))
         end do
         if (len(nodes) > 0) nodes = ', last at the nodes'//nodes
         call raise(error, error_code%not_converged, 'E0520', 'stick and slip cycle after '// &
            & to_text(scene%answer%iterations)//' iterations'//nodes, &
            & model%step(scene%step)%at, &
            & note='Newton, the load in parts, a damped tangent, single changes, fixed bounds '// &
            & 'and coefficients that come down were all tried', &
            & help='smaller increments, or ELASTIC SLIP= on *FRICTION, which lets points give '// &
            & 'way before they slip; a body that friction hardly holds needs more friction, or '// &
            & 'a support')
      end if
   end subroutine explain
end module lopin_friction_report

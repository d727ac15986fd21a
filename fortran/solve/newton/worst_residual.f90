!> Where Newton's residual is worst, and which contacts changed in the last iteration.
module lopin_worst_residual
   use lopin_kinds, only : wp
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_friction, only : has_friction
   use lopin_contact_row, only : contact_status
   use lopin_residual, only : evaluation_type
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: describe_worst

contains

   !> A phrase that follows the size of the residual; empty where there is nothing to name.
   function describe_worst(scene, model, evaluation, before) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(evaluation_type), intent(in) :: evaluation
      integer, intent(in) :: before(:)         !! (points) status an iteration ago; none: empty
      character(len=:), allocatable :: text
      integer :: dof, point, changed

      text = ''
      if (size(evaluation%unlevel) == 0) return
      dof = dof_of(scene, maxloc(abs(evaluation%unlevel), dim=1))
      if (dof == 0) return
      associate (node => scene%dofs%node(dof), c => scene%newton%contact)
         text = ', most at node '//to_text(model%mesh%node_label(node))//', dof '// &
            & to_text(scene%dofs%dof(dof))
         point = findloc(c%node(:c%n), node, dim=1)
         if (point > 0) text = text//' '//pair_of(scene, model, point)
         if (size(before) < c%n) return
         changed = count(c%status(:c%n) /= before(:c%n))
         if (changed == 0) return
         text = text//'; '//plural(changed, 'contact point')//' changed in the last iteration'
         ! The one at the worst node, or the first.
         if (point > 0) then
            if (c%status(point) == before(point)) point = 0
         end if
         if (point == 0) point = findloc(c%status(:c%n) /= before(:c%n), .true., dim=1)
         text = text//', node '//to_text(model%mesh%node_label(c%node(point)))//' '// &
            & pair_of(scene, model, point)//' from '//name_of(before(point), &
            & has_friction(c%friction(c%pair(point))))//' to '//name_of(c%status(point), &
            & has_friction(c%friction(c%pair(point))))
      end associate
   end function describe_worst

   function pair_of(scene, model, point) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      character(len=:), allocatable :: text

      associate (p => model%pair(scene%newton%contact%pair(point)))
         text = 'of pair ('//model%surface(p%slave)%name//', '//model%surface(p%master)%name//')'
      end associate
   end function pair_of

   pure function name_of(status, rubs) result(name)
      integer, intent(in) :: status
      logical, intent(in) :: rubs              !! there is friction
      character(len=:), allocatable :: name

      if (status == contact_status%stick) then
         name = 'sticking'
      else if (status == contact_status%slip) then
         name = trim(merge('sliding', 'closed ', rubs))
      else
         name = 'open'
      end if
   end function name_of

   !> The dof that counts most in an equation; 0: none.
   pure integer function dof_of(scene, equation) result(dof)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: equation
      real(wp) :: most
      integer :: k, i

      dof = 0
      most = 0.0_wp
      associate (c => scene%constraints)
         do i = 1, scene%dofs%n
            do k = c%first(i), c%first(i + 1) - 1
               if (c%equation(k) /= equation .or. .not. abs(c%coefficient(k)) > most) cycle
               most = abs(c%coefficient(k))
               dof = i
            end do
         end do
      end associate
   end function dof_of
end module lopin_worst_residual

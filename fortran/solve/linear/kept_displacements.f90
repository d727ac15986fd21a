!> Where tools that forces move stand after an answer, without the backward pass of the others.
!>
!> While a tool moves on, its increment is solved again, and nothing but its place is asked of the
!> displacements. The equations behind that are kept last by the factor: the end of the backward
!> pass has them.
module lopin_kept_displacements
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_condensed, only : columns_times
   use lopin_contact_points, only : pair_is_tied
   use lopin_linear_system, only : recover_kept
   use lopin_friction_stress, only : friction_reads_stress
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: tools_suffice, displace_tools, add_floating

contains

   !> A tool may move on, and what moves the tools is known from the equations kept last alone.
   logical function tools_suffice(scene, model) result(suffice)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, body, k

      suffice = .false.
      if (.not. scene%tools_first .or. .not. scene%system%splits) return
      if (size(scene%system%late) > 0 .or. friction_reads_stress(scene, model)) return
      do pair = 1, size(model%pair)
         if (scene%points%body(pair) == 0) cycle
         suffice = suffice .or. .not. pair_is_tied(model, model%pair(pair))
      end do
      do body = 1, size(model%rigid_body)
         if (.not. suffice) return
         do k = 1, 6
            suffice = suffice .and. is_kept(scene, scene%dofs%id(k, &
               & model%rigid_body(body)%reference))
         end do
      end do
   end function tools_suffice

   !> A dof follows from prescribed values, artificial supports and equations kept last.
   pure logical function is_kept(scene, dof) result(kept)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: dof               !! 0: none
      integer :: k

      kept = .true.
      if (dof == 0) return
      do k = scene%constraints%first(dof), scene%constraints%first(dof + 1) - 1
         associate (equation => scene%constraints%equation(k))
            kept = kept .and. (scene%system%place(equation) > 0 &
               & .or. scene%system%number(equation) == 0)
         end associate
      end do
   end function is_kept

   !> Displacements behind the tools; the others of the trial state mean nothing.
   subroutine displace_tools(scene, y, prescribed)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: y(:), prescribed(:)
      real(wp) :: v(scene%constraints%neq)

      call recover_kept(scene%system, y, columns_times(scene%problem, scene%answer%force), v)
      call add_floating(scene, v)
      call expand(scene%constraints, v, prescribed, scene%trial%motion%u)
      scene%system%forward = y
   end subroutine displace_tools

   !> Add the floating motions of the answer.
   pure subroutine add_floating(scene, v)
      type(scene_type), intent(in) :: scene
      real(wp), intent(inout) :: v(:)          !! (neq) [length]
      real(wp) :: floating(size(v))
      integer :: k

      if (scene%bodies%nq == 0) return
      floating = scene%bodies%motion(:, 1)*scene%answer%q(1)
      do k = 2, scene%bodies%nq
         floating = floating + scene%bodies%motion(:, k)*scene%answer%q(k)
      end do
      v = v + floating
   end subroutine add_floating
end module lopin_kept_displacements

!> Elements that are about to fold, named while the results can still be trusted.
module lopin_judge_mesh
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_corner_shape, only : worst_corner
   use lopin_scene, only : scene_type
   use lopin_say_once, only : say_once
   implicit none
   private
   public :: judge_mesh

   !> Scaled Jacobian at a corner below which it is about to fold, if deformation has taken half.
   real(wp), parameter :: about_to_fold = 0.1_wp, spoiled = 0.5_wp

contains

   !> Warn once a step of the worst corner of the accepted displacements.
   subroutine judge_mesh(scene, model, increment)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment
      real(wp) :: x(model%mesh%ndim, size(model%mesh%conn, 1)), least, value, before
      integer :: e, a, worst, node, n, corner

      least = about_to_fold
      worst = 0
      node = 0
      do e = 1, model%mesh%nelement
         if (scene%solids%which(e) == 0) cycle
         associate (cell => scene%solids%group(scene%solids%which(e))%element%cell)
            n = cell%ncorner
            do a = 1, n
               x(:, a) = place(model%mesh%conn(a, e))
            end do
            call worst_corner(cell, x, value, corner)
            if (.not. value < least) cycle
            call worst_corner(cell, model%mesh%x(:, model%mesh%conn(:n, e)), before, a)
            if (.not. value < spoiled*before) cycle
         end associate
         least = value
         worst = e
         node = model%mesh%conn(corner, e)
      end do
      if (worst == 0) return
      call say_once(scene%log, 'W0531', 'element '//to_text(model%mesh%element_label(worst))// &
         & ' is about to fold at node '//to_text(model%mesh%node_label(node))//' in step '// &
         & to_text(scene%step)//', increment '//to_text(increment)//': its scaled Jacobian is '// &
         & to_text(least, 3), model%step(scene%step)%at, &
         & help='a mesh made for the deformed shape, or finer where the body turns round an edge')

   contains

      function place(node) result(at)
         integer, intent(in) :: node
         real(wp) :: at(model%mesh%ndim)
         integer :: k

         at = model%mesh%x(:, node)
         do k = 1, size(at)
            if (scene%dofs%id(k, node) > 0) at(k) = at(k) + scene%u(scene%dofs%id(k, node))
         end do
      end function place
   end subroutine judge_mesh
end module lopin_judge_mesh
